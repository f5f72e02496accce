"""What the matcher does with one scan: its iterations, its cost, its covariances. Values without drawing."""

"""Many runs: every recording with every setting, over any executor, one row a run."""

"""Section V: what aids the filter besides the match: sensors, their corrections, and the gates before them."""

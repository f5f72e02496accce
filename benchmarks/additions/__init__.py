"""What each addition of the defaults to the paper's method is worth, when it alone is switched off."""

"""The groups of settings, one file a part of the paper."""

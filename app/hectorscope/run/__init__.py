"""A run as a value: pipeline, settings and their changes, headless runner, figures."""

"""The application around the core: sources in, a page and files out."""

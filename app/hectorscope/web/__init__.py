"""The viser server, its gate, and every use of private parts of viser."""

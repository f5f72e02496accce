"""Section IV: from a sweep to endpoints in the stabilised frame."""

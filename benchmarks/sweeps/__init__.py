"""What sweeps cost, whether their score can be trusted, what one finds, and the page of figures made by one."""

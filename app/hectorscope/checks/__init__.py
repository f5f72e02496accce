"""What the sensors say of each other, what contradicts their messages, and the options that repair it."""

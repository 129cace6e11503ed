"""How the open take was read: its rate and sides, why, and the means to read it otherwise."""

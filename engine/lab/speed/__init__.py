"""How fast the methods are: `methods.METHODS` measures each, `timing` is what they measure with."""

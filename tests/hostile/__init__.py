"""Files that were damaged or made to harm, for every reader: mutations by the thousand, each under limits."""

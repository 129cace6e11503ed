"""What every format rests on: whole writes, locks, budgets, and text and arrays of unknown origin."""

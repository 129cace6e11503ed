"""From what is said to what the mouth does: phones and the visemes they belong to."""

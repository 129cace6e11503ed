"""A face from a phone as it happens: decode, clean, record, and play a take back as if it were a phone."""

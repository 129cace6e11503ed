"""What trains, measures and builds; nothing that ships imports it."""

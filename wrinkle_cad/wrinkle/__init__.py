"""What a script holds in its hand: a strip, its pattern, its numbers."""

"""A piece of the pattern: sew line, allowance, notches, texts, and what a user may ask of it."""

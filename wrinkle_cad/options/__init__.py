"""One option, one place: a field of a settings class states all there is to know about an option.

Flags, TOML keys, checks and help are derived from the field; nothing else lists options.
"""

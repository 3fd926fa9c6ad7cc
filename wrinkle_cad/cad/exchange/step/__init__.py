"""The text of STEP files (ISO 10303-21): what the kernel drops or writes differently each time."""

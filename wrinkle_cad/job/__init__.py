"""One run: settings, from the file read to the outputs written."""

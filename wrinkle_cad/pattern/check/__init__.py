"""Another program's DXF: read as plain lines and judged before it is cut."""

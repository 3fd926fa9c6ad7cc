"""Many files, unattended: workers with limits, a manifest to resume from, a summary at the end."""

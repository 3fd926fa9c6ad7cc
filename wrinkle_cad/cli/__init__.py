"""The command line: flags, terminal, exit codes; nothing else."""

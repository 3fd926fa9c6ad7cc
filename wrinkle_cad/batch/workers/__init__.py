"""Who does the jobs of a batch: processes with limits, an executor of the caller's, a cluster."""

"""The folder a batch fills: inputs, plan, outputs, manifest, summary."""

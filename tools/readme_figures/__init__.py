"""Where the figures of the READMEs come from: what stands behind `tools/figures`."""

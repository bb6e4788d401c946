"""The geometry work: construct, verify, unroll, nest, write.  No files, no clocks, no environment."""

"""The parts of scripts/same-results."""

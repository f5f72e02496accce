"""Sensor checks: statistics of the data, contradictions to the messages, and the options that repair them."""

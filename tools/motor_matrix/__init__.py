"""Does every motor hold: motor x plant x move x feedback."""

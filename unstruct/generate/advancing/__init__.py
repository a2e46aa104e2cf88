"""What the fronts of the plane and of space share: trees of boxes, rows that come and go, queues, records."""

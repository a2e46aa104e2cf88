"""From points, and segments between them, to cells (12.2.1, 12.2.2, 12.2.4). Knows no domain and no size."""

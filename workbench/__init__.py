"""Panel dashboards over :mod:`corpus_tools`: label, inspect, blend, judge joins, export."""

__all__: list[str] = []

"""One readable version of each algorithm: what a chapter lists and steps through, the oracle of the tests.

Nothing here shares code with the fast kernels: sets, dictionaries and ``fractions.Fraction`` only.
"""

"""The library of machine code, made ahead of time: `python -m tlismni.core.aot`.

It imports the whole core, so it stands above all of it and not in `compiled`, which knows nothing of what it compiles.
What finds and calls the library is `compiled/library.py`.
"""

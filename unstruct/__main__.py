"""``python -m unstruct``: the command, where scripts of packages are not on the path."""

from .command import main

if __name__ == "__main__":
    main(prog_name="python -m unstruct")

"""Is a mesh what it claims to be, and how good is it?"""

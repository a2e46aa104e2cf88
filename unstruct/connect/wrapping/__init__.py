"""Face by face: gift wrapping of given points and from a given front."""

def plan_mesh(mesh):
    raise NotImplementedError

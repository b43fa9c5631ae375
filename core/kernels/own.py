"""Columns of the rows that hold what is each joint's own: its stiffness, its limit, its work.

A limit's tasks work in such a row. Addresses are below 2^53, so they fit in as they are.
"""

ANGLES, MARGIN, STEP, OTHER = 0, 3, 4, 7
LIMIT = 10  # address of the joint's own limit: 0 = none, negative = the mirror image of one
TASKS = 11  # address of what carries out tasks on such joints
PARAMS = 12  # of the limit
TASK_WIDTH = 28  # what tasks for a finish need, from the first column on

OPERATING, TARGET, ZONE, RELATIVE, WANTED = 28, 31, 34, 35, 44
COMPLIANCE = 53  # share of its turn the joint makes in CCD: 1 less its stiffness
KEPT = 54  # angles that are set aside by the choice of a solution, three times three
WIDTH = 63

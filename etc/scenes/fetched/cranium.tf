# value r g b a      Hounsfield units from LO to HI, opacity per voxel length: bone alone
range -1000 2000
0.00 0.00 0.00 0.00 0.0
0.40 0.85 0.72 0.58 0.0
0.46 0.92 0.84 0.70 0.70
0.60 0.97 0.93 0.84 0.95
1.00 1.00 0.98 0.94 1.00

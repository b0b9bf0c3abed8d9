#!/usr/bin/env python3
"""local_law.py: the law of local points (lib/contact/contact_face.c) on a half-space of springs that is scaled as a solid: force of
a sphere over that on the solid, by radius and depth in spacings, on a node, between two, on a diagonal, in mid-triangle and at three
places more. usage: local_law.py [POISSON]. The surface's linear triangles move by the half-space's normal displacements (local_compliance.py), small strains. The sphere on the solid is a true sphere (Segedin 1957), 2 % below Hertz's paraboloid at a fifth of its radius."""
import itertools
import math
import sys

from local_compliance import CELLS, compliance

STEP = math.pi / CELLS
half = [(i + 0.5) * STEP for i in range(CELLS)]
POISSON = float(sys.argv[1]) if len(sys.argv) > 1 else 0.25
T = [[compliance(x, y, POISSON) for y in half] for x in half]
ES = 0.8 / (1 - POISSON)  # E / (1 - ratio^2) of the solid, with the springs' modulus 1
SOLID = ES * 15 / 16
MIRRORED = 1.6155 / (2 * CELLS) / (math.pi * ES)  # of the images with alternating sign at 2 CELLS spacings


def node_displacement(a, b):
    """By a unit force on a node a and b spacings away."""
    return MIRRORED + sum(T[i][j] * math.cos(half[i] * a) * math.cos(half[j] * b)
                          for i in range(CELLS) for j in range(CELLS)) / CELLS ** 2


GT = [[node_displacement(a, b) for b in range(10)] for a in range(10)]


def solve(A,b):
    n=len(b); A=[r[:]+[v] for r,v in zip(A,b)]
    for i in range(n):
        p=max(range(i,n),key=lambda k:abs(A[k][i])); A[i],A[p]=A[p],A[i]
        for k in range(i+1,n):
            f=A[k][i]/A[i][i]
            if f:
                for j in range(i,n+1): A[k][j]-=f*A[i][j]
    x=[0]*n
    for i in range(n-1,-1,-1): x[i]=(A[i][n]-sum(A[i][j]*x[j] for j in range(i+1,n)))/A[i][i]
    return x

def points(cx,cz,rad,q):
    out=[]
    m=int(rad)+2
    for a,b in itertools.product(range(-m,m+1),repeat=2):
        for tri in (((a,b),(a+1,b),(a+1,b+1)),((a,b),(a+1,b+1),(a,b+1))):
            for u in range(q):
                for v in range(2*(q-u)-1):
                    d=1+(v&1); s1=(u+d/3)/q; s2=(v//2+d/3)/q; s=(1-s1-s2,s1,s2)
                    x=sum(t[0]*w for t,w in zip(tri,s)); z=sum(t[1]*w for t,w in zip(tri,s))
                    rho=math.hypot(x-cx,z-cz)
                    if rho<rad: out.append((rho,tri,s,1-sum(w*w for w in s),.5/q/q))
    return out

def solid(r,d):
    """Force of a sphere of radius r, d deep in the half-space; the springs' modulus 1."""
    low,high=0.,r*(1-1e-12)
    for _ in range(100):
        a=.5*(low+high)
        if .5*a*math.log((r+a)/(r-a))<d: low=a
        else: high=a
    return ES*(.5*(a*a+r*r)*math.log((r+a)/(r-a))-a*r)

def force(law,r,d,y):
    """Force over the solid's of a sphere of radius r, d deep, at y of a cell; spacing and Young's modulus 1. Parts of an edge as in
    contact_find.c, whose mean edge is 1.14 spacings."""
    q=min(max(math.ceil(2.5*1.138/r),3),12)
    P=points(y[0],y[1],min(math.sqrt(2*r*d)*1.02,.97*r),q)
    nodes=sorted({n for p in P for n in p[1]}); ix={n:i for i,n in enumerate(nodes)}; n=len(nodes)
    Gm=[[GT[abs(a[0]-b[0])][abs(a[1]-b[1])] for b in nodes] for a in nodes]
    PT=[(d-(r-math.sqrt(r*r-p[0]**2)),[ix[t] for t in p[1]],p[2],p[3],p[4]) for p in P]
    w=[0.]*n
    for it in range(60):
        f=[0.]*n; K=[[0.]*n for _ in range(n)]
        for g,ii,s,m2,A in PT:
            u=g-sum(w[i]*x for i,x in zip(ii,s))
            if u<=0: continue
            pr,sl=law(u,r,m2)
            for i,x in zip(ii,s):
                f[i]+=A*pr*x
                for j,y2 in zip(ii,s): K[i][j]+=A*sl*x*y2
        R=[w[i]-sum(Gm[i][j]*f[j] for j in range(n)) for i in range(n)]
        if max(map(abs,R))<1e-7*d: break
        J=[[(i==j)+sum(Gm[i][k]*K[k][j] for k in range(n)) for j in range(n)] for i in range(n)]
        dw=solve(J,R)
        t=1. if it<15 else .5
        w=[a-t*b for a,b in zip(w,dw)]
    return sum(f)/solid(r,d)


def law(u, r, m):
    """Pressure and its slope at the depth u; m: 1 less the squares of the point's shares."""
    t = 1 - 1.5 * m  # 1 on a node, 0 in mid-triangle
    root, linear, steep = ES / math.pi / math.sqrt(r), 0.95 - 2.05 * t, (8.1 + 20.2 * t) * t * math.sqrt(r)
    linear, steep = SOLID ** 2 * linear, SOLID ** 2 * steep
    s = math.sqrt(u)
    return root * s + linear * u + steep * u * s, 0.5 * root / s + linear + 1.5 * steep * s


PLACES = ((0, 0), (0.5, 0), (0.5, 0.5), (2 / 3, 1 / 3), (0.3, 0.1), (0.25, 0.25), (0.15, 0.35))
print("%6s %6s %6s  %s" % ("radius", "depth", "a/h", "force over the solid's: node, edge, diagonal, triangle, three more"))
most = 0
for radius, depth in ((0.5, 0.083), (0.5, 0.167), (0.75, 0.125), (0.75, 0.25), (0.83, 0.083), (1.25, 0.125), (1.25, 0.25),
                      (1.25, 0.5), (1.67, 0.083), (2.08, 0.208), (2.08, 0.417), (2.08, 0.83), (2.5, 0.125), (2.5, 0.25),
                      (4.17, 0.208), (4.17, 0.417)):
    over = [force(law, radius, depth, y) for y in PLACES]
    most = max(most, *(abs(f - 1) for f in over))
    print("%6.2f %6.3f %6.2f  " % (radius, depth, math.sqrt(radius * depth)), " ".join("%.3f" % f for f in over))
print("largest error %.3f" % most)

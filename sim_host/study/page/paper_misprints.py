"""Where the paper's print is wrong: each formula as printed and as it must be, against its own definition.

The definitions are built here from the positions of the masses and differentiated numerically; nothing is
taken from the C code.
"""
import numpy as np

M, m, l = 1.3, 0.4, 0.9  # no value equal to 1, so that a lost factor shows


def points(q):
    """Hip, stance leg's mass, swing leg's mass, swing toe."""
    ts, tn, r = q
    up, down = np.array([np.sin(ts), np.cos(ts)]), np.array([np.sin(tn), np.cos(tn)])
    hip = (l + r) * up
    return hip, (r + l / 2) * up, hip - l / 2 * down, hip - l * down


def jacobian(index, q):
    columns, h = [], 1e-6
    for k in range(3):
        up, down = np.array(q, float), np.array(q, float)
        up[k] += h
        down[k] -= h
        columns.append((points(up)[index] - points(down)[index]) / (2 * h))
    return np.array(columns).T


def collision(q):
    """q+ = H q-, by its definition (paper eq. 10)."""
    mass = sum(w * jacobian(i, q).T @ jacobian(i, q) for i, w in ((0, M), (1, m), (2, m)))
    toe = jacobian(3, q)
    inverse = np.linalg.inv(mass)
    return np.eye(3) - inverse @ toe.T @ np.linalg.inv(toe @ inverse @ toe.T) @ toe


def appendix_h31(q, lost_term):
    ts, tn, r = q
    divisor = (-l ** 2 * (7 * m + 8 * M) - 16 * l * (m + M) * r - 2 * (5 * m + 4 * M) * r ** 2 +
               m * l * (3 * l + 4 * r) * np.cos(2 * (ts - tn)))
    bracket = l ** 2 * (3 * m + 4 * M) + lost_term * 8 * l * (m + M) * r + (6 * m + 4 * M) * r ** 2
    return -(l + r) * np.sin(2 * (ts - tn)) * bracket / divisor


def checks(data):
    """(place, what is printed, what is right, check in words, error as printed, error as right)."""
    q, rate = (-0.35, 0.35, 0.11), np.array([-1.1, 0.6, 0.2])
    start, zero = (-0.35, 0.35, 0.0), np.array([-1.1, 0.6, 0.0])
    toe = jacobian(3, q)
    d = start[0] - start[1]
    printed = ((2 * m * l * np.sin(d) * zero[1] - (3 * m + 4 * M) * np.sin(2 * d) * zero[0]) /
               (7 * m + 8 * M + 3 * np.cos(2 * d)))
    right = (((3 * m + 4 * M) * l * np.sin(2 * d) * zero[0] - 2 * m * l * np.sin(d) * zero[1]) /
             (7 * m + 8 * M - 3 * m * np.cos(2 * d)))
    defined = (collision(start) @ zero)[2]
    printed_toe = np.array([[q[2] * np.cos(q[0])], [-q[2] * np.sin(q[0])]])
    right_toe = np.array([[(l + q[2]) * np.cos(q[0])], [-(l + q[2]) * np.sin(q[0])]])
    h31 = collision(q)[2, 0]
    largest = {kp: max(row["largest"] for row in data["gain"]
                       if row["kp"] == kp and 0.05 <= row["r0_m"] <= 0.27) for kp in (-0.042, 0.042)}
    clamped = [row for row in data["long"] if row["clamped_strides"] > 0]
    return [
        ("eq. (7)", "first column of J<sub>c</sub>: r cos &theta;<sub>s</sub>, &minus;r sin &theta;<sub>s</sub>",
         "(l + r) in place of r", "toe velocity by differences of the toe's position, largest error in m",
         float(np.abs(toe[:, :1] - printed_toe).max()), float(np.abs(toe[:, :1] - right_toe).max())),
        ("eq. (11)", "2 m l sin(D) &theta;<sub>n</sub>&prime; &minus; (3m + 4M) sin(2D) &theta;<sub>s</sub>&prime; over "
         "7m + 8M + 3 cos(2D)",
         "the sign turned, an l with the second term, an m with the cosine and its sign turned",
         "r&prime;<sup>+</sup> of eq. (10) built from the masses, error in m/s", abs(printed - defined),
         abs(right - defined)),
        ("Appendix, H<sub>31</sub>", "bracket l&sup2;(3m+4M) + (6m+4M) r&sup2;", "+ 8 l (m+M) r, as in H<sub>21</sub>",
         "entry of eq. (10) built from the masses, error", float(abs(appendix_h31(q, 0) - h31)),
         float(abs(appendix_h31(q, 1) - h31))),
        ("r&prime;<sup>+</sup> &lt; 0", "listed among the faults that end a trial",
         "clamped to 0: the walker stops and the spring starts it again",
         f"gaits of the long branch with the clamp acting: {len(clamped)} of those followed, from r<sub>0</sub> = "
         f"{min((row['parameter'] for row in clamped), default=float('nan')):.4f} m; treated as a fault they, and all of "
         "Table 2 above it, are lost", None, None),
        ("eq. (16)", "r<sub>0</sub> = f<sup>&minus;1</sup>(v*) &minus; k<sub>p</sub>(v* &minus; v) with v = "
         "&theta;<sub>s</sub>&prime; &lt; 0",
         "with forward speed v = &minus;&theta;<sub>s</sub>&prime;",
         "largest eigenvalue over 0.05 &le; r<sub>0</sub> &le; 0.27 with k<sub>p</sub> = 0.042 (stable below 1)",
         largest[-0.042], largest[0.042]),
    ]

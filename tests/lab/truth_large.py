"""Exact bias and variance of k/u at large k, to 20 digits: writes truth_large.csv. Needs mpmath."""
from mpmath import mp, mpf, hyp2f1, nstr

mp.dps = 80
KS = [10**5 + 7, 10**6, 10**6 + 1, 10**9 + 1, 10**12, 10**12 + 1]


def shell(k):
    x = int(mp.floor((mp.sqrt(8 * mpf(k) + 1) - 1) / 2))
    if x * (x + 1) // 2 < k:
        x += 1
    return x, k - x * (x - 1) // 2


def moments(k, end, x, j, d, q):
    first = hyp2f1(d, x + 1 - j, x + 1, q) / end
    second = hyp2f1(2 * d, x + 1 - j, x + 1, q) / end**2
    return k * first - 1, k * k * (second - first * first)


def rows(k):
    k = mpf(k)
    yield "strat1d_same", moments(k, k, 2, 2, 1, 2 / k)
    yield "strat1d_diff", moments(k, k + 1, 2, 1, 1, 2 / (k + 1))
    yield "basic", moments(k, k, 1, 1, 1, 1 / k)
    x, j = shell(int(k))
    x, j = mpf(x), mpf(j)
    end = x * (x + 1) / 2
    yield "order_volume", moments(k, end, x, j, 1, 2 / (x + 1))
    for d in (2, 3):
        q = 1 - ((x - 1) / (x + 1)) ** (mpf(1) / d)
        yield f"order{d}d_radius", moments(k, end, x, j, d, q)


with open("truth_large.csv", "w") as out:
    print("model,k,bias,var", file=out)
    for k in KS:
        for model, (bias, var) in rows(k):
            print(model, k, nstr(bias, 20), nstr(var, 20), sep=",", file=out)

"""Raystream's principled material as a plugin for Mitsuba 3, written from its documentation.

Mitsuba's own distribution of microfacets and its Fresnel terms serve here, and how much light one
microfacet sends on is found by integrating them: it shares formulas with Raystream, but no code and
no table. A variant must be set before this is imported.
"""

import drjit as dr
import mitsuba as mi

COSINES, AZIMUTHS, POINTS = 96, 24, 1 << 14
COAT_F0 = 0.04


def fifth(cosine):
    """How far Schlick's term has gone from normal incidence."""
    return dr.clip(1 - cosine, 0, 1) ** 5


class Table:
    """Two numbers by direction, the means of `weigh` over points of the unit square."""

    def __init__(self, weigh, has_azimuth):
        azimuths = AZIMUTHS if has_azimuth else 1
        index = dr.arange(mi.UInt32, COSINES * azimuths)
        root = (mi.Float(index % COSINES) + 0.5) / COSINES
        turn = (mi.Float(index // COSINES) + 0.5) / azimuths * (dr.pi / 2)
        z = dr.square(root)
        ring = dr.sqrt(1 - z * z)
        o = mi.Vector3f(ring * dr.cos(turn), ring * dr.sin(turn), z)
        pair = self.integrate(weigh, o)
        mean = lambda it: dr.mean(it * 4 * root**3)[0]
        self.mean = mean(pair.x), mean(pair.y)
        texels = mi.TensorXf(dr.ravel(pair), (azimuths, COSINES, 2))
        self.texture = mi.Texture2f(
            texels, use_accel=False, filter_mode=dr.FilterMode.Linear,
            wrap_mode=dr.WrapMode.Clamp)

    @dr.syntax
    def integrate(self, weigh, o):
        """A generalised golden ratio makes the points (Roberts 2018)."""
        k, sum_a, sum_b = mi.UInt32(0), mi.Float64(0), mi.Float64(0)
        while k < POINTS:
            # The fractions of products, as the words have them that overflow.
            u = mi.Float(k * mi.UInt32(3242174889)) * 2**-32
            v = mi.Float(k * mi.UInt32(2447445414)) * 2**-32
            a, b = weigh(o, mi.Point2f(u, v))
            sum_a += mi.Float64(a)
            sum_b += mi.Float64(b)
            k += 1
        return mi.Vector2f(mi.Float(sum_a / POINTS), mi.Float(sum_b / POINTS))

    def at(self, w, active=True):
        turn = dr.atan2(dr.abs(w.y), dr.abs(w.x)) / (dr.pi / 2)
        pair = self.texture.eval(mi.Point2f(dr.sqrt(dr.clip(dr.abs(w.z), 0, 1)), turn), active)
        return pair[0], pair[1]


class Facets:
    """Microfacets of GGX; the table has what one of them reflects, by Schlick's two terms."""

    def __init__(self, along, across, is_independent=False, is_single=False):
        """Masked towards both directions independently, and one of them alone, if that is wanted."""
        self.is_independent, self.is_single = is_independent, is_single
        self.distribution = mi.MicrofacetDistribution(mi.MicrofacetType.GGX, along, across)
        self.table = Table(self.weigh, along != across)

    def weigh(self, o, u):
        h, _ = self.distribution.sample(o, u)
        i = mi.reflect(o, h)
        weight = dr.select(i.z > 0, self.both(o, i, h) / self.one(o, h), 0)
        grazing = fifth(dr.dot(o, h))
        return weight * (1 - grazing), weight * grazing

    def one(self, w, h):
        """Share of the facets that `w` sees."""
        return self.distribution.smith_g1(w, h)

    def both(self, o, i, h):
        """The same of two directions on one side, height-correlated (Heitz 2014)."""
        if self.is_independent:
            return self.one(o, h) * self.one(i, h)
        return dr.rcp(dr.rcp(self.one(o, h)) + dr.rcp(self.one(i, h)) - 1)

    def lobe(self, o, i):
        """What one facet reflects but for its Fresnel term, its density, and that term's cosine."""
        h = dr.normalize(o + i)
        distribution = self.distribution.eval(h) / (4 * o.z)
        return distribution * self.both(o, i, h), distribution * self.one(o, h), dr.dot(o, h)

    def missed(self, w):
        if self.is_single:
            return mi.Float(0)
        a, b = self.table.at(w)
        return dr.maximum(1 - a - b, 0)

    @property
    def missed_mean(self):
        return 1 - sum(self.table.mean)


class Reflector:
    """Facets with a Fresnel term, and what several of them do (Fdez-Aguera 2019)."""

    def __init__(self, facets, f0, mean=None, fresnel=None):
        self.facets, self.f0 = facets, f0
        self.fresnel = fresnel or (lambda cosine: f0 + (1 - f0) * fifth(cosine))
        mean = f0 + (1 - f0) / 21 if mean is None else mean
        missed = facets.missed_mean
        self.several = mean * mean * (1 - missed) / (1 - mean * missed)

    def passes(self, w=None):
        table = self.facets.table
        a, b = table.mean if w is None else table.at(w)
        return 1 - (self.f0 * a + b) - self.several * dr.maximum(1 - a - b, 0)


class Boundary:
    """A rough boundary (Walter et al. 2007), and what several of its facets do."""

    def __init__(self, alpha, ior):
        self.ior = ior
        self.distribution = mi.MicrofacetDistribution(mi.MicrofacetType.GGX, alpha)
        self.tables = [Table(lambda o, u: self.weigh(o, u, eta), False) for eta in (ior, 1 / ior)]
        means = [1 - table.mean[0] for table in self.tables]
        self.means = means
        # Share of what several do that crosses, from outside and from inside.
        self.crossing = [
            means[1] * ior**2 / (means[1] * ior**2 + means[0]),
            means[0] / (means[0] + means[1] * ior**2)]

    def weigh(self, o, u, eta):
        h, _ = self.distribution.sample(o, u)
        fresnel, far, _, back = mi.fresnel(dr.dot(o, h), eta)
        up, down = mi.reflect(o, h), mi.refract(o, h, far, back)
        g = lambda w: self.distribution.smith_g1(w, dr.select(w.z < 0, -1, 1) * h)
        both = dr.rcp(dr.rcp(g(o)) + dr.rcp(g(up)) - 1)
        reflected = dr.select(up.z > 0, fresnel * both / g(o), 0)
        passed = dr.select((fresnel < 1) & (down.z < 0), (1 - fresnel) * g(-down), 0)
        return reflected + passed, mi.Float(0)

    def sides(self, outside):
        pick = lambda pair: dr.select(outside, pair[0], pair[1])
        return dr.select(outside, self.ior, 1 / self.ior), pick

    def missed(self, w, outside):
        here, there = [dr.maximum(1 - table.at(w)[0], 0) for table in self.tables]
        return dr.select(outside, here, there)

    def sample(self, o, outside, choice, u):
        """A direction by one facet, and whether it is to cross."""
        eta, _ = self.sides(outside)
        h, _ = self.distribution.sample(o, u)
        fresnel, far, _, back = mi.fresnel(dr.dot(o, h), eta)
        crosses = choice >= fresnel
        return dr.select(crosses, mi.refract(o, h, far, back), mi.reflect(o, h)), crosses

    def evaluate(self, o, i, outside):
        """BSDF times cosine, and the density of `sample`."""
        eta, pick = self.sides(outside)
        crosses = i.z < 0
        up = mi.Vector3f(i.x, i.y, dr.abs(i.z))
        h = dr.normalize(dr.select(crosses, o + i * eta, o + i))
        h = mi.Vector3f(dr.mulsign(h, h.z))
        here, there = dr.dot(o, h), dr.dot(i, h)
        fresnel, _, _, _ = mi.fresnel(dr.clip(here, 0, 1), eta)
        d, g1 = self.distribution.eval(h), lambda w: self.distribution.smith_g1(w, h)
        g_o, g_i = g1(o), self.distribution.smith_g1(up, mi.Vector3f(0, 0, 1))
        reflected = fresnel * d / (4 * o.z)
        spread = here + eta * there
        passed = (1 - fresnel) * d * here * -there / (dr.square(spread) * o.z)
        passed = dr.select((here > 0) & (there < 0), passed, 0)
        once = dr.select(crosses, passed * g_o * g_i, reflected / (1 / g_o + 1 / g_i - 1))
        pdf = dr.select(crosses, passed * eta * eta, reflected) * g_o
        crossing = pick(self.crossing)
        share = dr.select(crosses, crossing / (eta * eta), 1 - crossing)
        mean = dr.select(crosses, pick(self.means[::-1]), pick(self.means))
        far = self.missed(i, outside ^ crosses)
        several = share * self.missed(o, outside) * far / mean * dr.abs(i.z) / dr.pi
        return once + several, pdf


class Sheen:
    """Fibres (Estevez and Kulla 2017), with the visibility of Neubelt and Pettineo (2013)."""

    def __init__(self, roughness):
        self.roughness = max(roughness, 0.2)
        even = lambda u: mi.warp.square_to_uniform_hemisphere(u)
        weigh = lambda o, u: (self.raw(o, even(u)) * (2 * dr.pi), mi.Float(0))
        self.table = Table(weigh, False)

    def raw(self, o, i):
        h = dr.normalize(o + i)
        sharpness = 1 / self.roughness**2
        sine2 = dr.maximum(1 - h.z * h.z, 1e-12)
        distribution = (2 + sharpness) * sine2 ** (0.5 * sharpness) / (2 * dr.pi)
        return distribution * i.z / (4 * (o.z + i.z - o.z * i.z))

    def albedo(self, o):
        return dr.minimum(self.table.at(o)[0], 1)

    def value(self, o, i):
        return self.raw(o, i) / dr.maximum(self.table.at(o)[0], 1)


class RaystreamPrincipled(mi.BSDF):
    """The material. Its numbers are those of the list `described`, by the keys of scene files.

    "independent masking" and "one facet" make its surface another renderer's.
    """

    described = []

    def __init__(self, props):
        mi.BSDF.__init__(self, props)
        keys = self.described[int(props["index"])]
        get = lambda key, other=0.0: keys.get(key, other)
        self.colour = mi.Color3f(get("reflectance", [1.0, 1.0, 1.0]))
        self.passing = (1 - get("metallic")) * get("transmission")
        self.metal = 1.0 if "eta" in keys else get("metallic") / max(1 - self.passing, 1e-9)
        across = max(get("roughness") ** 2, 1e-3)
        self.facets = Facets(
            across + (1 - across) * get("anisotropy") ** 2, across,
            get("independent masking", False), get("one facet", False))
        straight = ((get("ior", 1.5) - 1) / (get("ior", 1.5) + 1)) ** 2
        f0 = dr.minimum(mi.Color3f(get("specular", [1.0, 1.0, 1.0])) * straight, 1)
        self.over_base = Reflector(self.facets, f0)
        self.of_metal = self.conductor(keys) if "eta" in keys else Reflector(
            self.facets, self.colour)
        self.boundary = Boundary(across, get("ior", 1.5)) if self.passing > 0 else None
        self.coat = get("coat")
        rough = max(get("coat_roughness") ** 2, 1e-3)
        self.coat_facets = Facets(rough, rough) if self.coat > 0 else None
        self.sheen_colour = mi.Color3f(get("sheen", [0.0, 0.0, 0.0]))
        self.sheen = Sheen(get("sheen_roughness")) if "sheen" in keys else None
        sides = mi.BSDFFlags.FrontSide | mi.BSDFFlags.BackSide
        flags = mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.Anisotropic | sides
        if self.boundary:
            flags |= mi.BSDFFlags.GlossyTransmission | mi.BSDFFlags.NonSymmetric
        self.m_flags, self.m_components = flags, [flags]

    def conductor(self, keys):
        index = [mi.Complex2f(eta, k) for eta, k in zip(keys["eta"], keys["k"])]
        fresnel = lambda cosine: mi.Color3f(
            [mi.fresnel_conductor(dr.clip(cosine, 0, 1), each) for each in index])
        cosines = (mi.Float(dr.arange(mi.UInt32, 4096)) + 0.5) / 4096
        reflected = fresnel(cosines)
        mean = mi.Color3f([dr.mean(2 * cosines * each)[0] for each in reflected])
        return Reflector(self.facets, fresnel(mi.Float(1)), mean, fresnel)

    def upright(self, si, wo):
        """Both directions as if the path came from above, and whether it comes from outside."""
        outside = si.wi.z > 0
        turn = lambda w: mi.Vector3f(w.x, w.y, dr.select(outside, w.z, -w.z))
        o = turn(si.wi)
        return mi.Vector3f(o.x, o.y, dr.maximum(o.z, 1e-4)), turn(wo), outside

    def chances(self, outside):
        """Of the lobes surface, cosine above, boundary, cosine below, coat and sheen."""
        covered = outside if self.boundary else mi.Bool(True)
        of = lambda share, there=True: dr.select(there, mi.Float(1 if share else 0), 0)
        chances = [
            of(self.passing < 1), of(True), 3 * of(self.boundary), of(self.boundary),
            of(self.coat_facets, covered), of(self.sheen, covered)]
        return [chance / sum(chances) for chance in chances]

    def reflected(self, o, i):
        """What the surface and the base reflect."""
        surface, _, cosine = self.facets.lobe(o, i)
        mix = lambda f: f(self.over_base) * (1 - self.metal) + f(self.of_metal) * self.metal
        missed = self.facets.missed(o) * self.facets.missed(i) / self.facets.missed_mean
        base = self.over_base.passes(o) * self.over_base.passes(i) / self.over_base.passes()
        base *= self.colour * (1 - self.metal)
        value = mix(lambda it: it.fresnel(cosine)) * surface
        return value + (mix(lambda it: it.several) * missed + base) * i.z / dr.pi

    def eval_pdf(self, ctx, si, wo, active=True):
        o, i, outside = self.upright(si, wo)
        above = i.z > 0
        up = mi.Vector3f(i.x, i.y, dr.maximum(dr.abs(i.z), 1e-6))
        chances = self.chances(outside)
        value = dr.select(above, self.reflected(o, up) * (1 - self.passing), 0)
        pdf = dr.select(above, chances[0] * self.facets.lobe(o, up)[1], 0)
        pdf += dr.select(above, chances[1], chances[3]) * up.z / dr.pi
        if self.boundary:
            passed, density = self.boundary.evaluate(o, i, outside)
            value += dr.select(above, mi.Color3f(1), self.colour) * passed * self.passing
            pdf += chances[2] * density
        # What is seen from within a body has its cover behind it.
        covered = outside if self.boundary else mi.Bool(True)
        cover, rest = mi.Color3f(0), mi.Float(1)
        if self.coat_facets:
            lobe, density, cosine = self.coat_facets.lobe(o, up)
            a, b = self.coat_facets.table.at(o)
            cover += self.coat * (COAT_F0 + (1 - COAT_F0) * fifth(cosine)) * lobe
            pdf += dr.select(above, chances[4] * density, 0)
            rest *= 1 - self.coat * (COAT_F0 * a + b)
        if self.sheen:
            cover += self.sheen_colour * rest * self.sheen.value(o, up)
            pdf += dr.select(above, chances[5] / (2 * dr.pi), 0)
            rest *= 1 - dr.max(self.sheen_colour) * self.sheen.albedo(o)
        value = dr.select(covered, value * rest + dr.select(above, cover, 0), value)
        active = active & (si.wi.z != 0) & (i.z != 0)
        if not self.boundary:
            active &= above
        return dr.select(active, value, 0), dr.select(active, pdf, 0)

    def eval(self, ctx, si, wo, active=True):
        return self.eval_pdf(ctx, si, wo, active)[0]

    def pdf(self, ctx, si, wo, active=True):
        return self.eval_pdf(ctx, si, wo, active)[1]

    def sample(self, ctx, si, sample1, sample2, active=True):
        o, _, outside = self.upright(si, si.wi)
        turn = lambda facets: mi.reflect(o, facets.distribution.sample(o, sample2)[0])
        chances = self.chances(outside)
        cosine = mi.warp.square_to_cosine_hemisphere(sample2)
        i, crosses = turn(self.facets), mi.Bool(False)
        end = chances[0]
        pick = lambda end, other: dr.select(sample1 >= end, other, i)
        i = pick(end, cosine)
        end = end + chances[1]
        if self.boundary:
            choice = (sample1 - end) / chances[2]
            passed, crosses = self.boundary.sample(o, outside, choice, sample2)
            crosses = (sample1 >= end) & (crosses | (sample1 >= end + chances[2]))
            i = pick(end, passed)
            i = pick(end + chances[2], -cosine)
        end = end + chances[2] + chances[3]
        crosses &= sample1 < end
        if self.coat_facets:
            i = pick(end, turn(self.coat_facets))
        if self.sheen:
            i = pick(end + chances[4], mi.warp.square_to_uniform_hemisphere(sample2))
        sample = dr.zeros(mi.BSDFSample3f)
        sample.wo = mi.Vector3f(i.x, i.y, dr.select(outside, i.z, -i.z))
        value, sample.pdf = self.eval_pdf(ctx, si, sample.wo, active)
        eta = self.boundary.sides(outside)[0] if self.boundary else 1
        sample.eta = dr.select(i.z < 0, eta, 1)
        sample.sampled_type = mi.UInt32(+self.m_flags)
        sample.sampled_component = mi.UInt32(0)
        # One facet sends no light where its reflection ends up below, or what passes above.
        valid = active & (sample.pdf > 0) & (crosses == (i.z < 0))
        return sample, dr.select(valid, value / sample.pdf, 0)


def described(keys):
    """The material with these keys of a scene file, for `mi.load_dict`."""
    RaystreamPrincipled.described.append(keys)
    return {"type": "raystream", "index": len(RaystreamPrincipled.described) - 1}


mi.register_bsdf("raystream", RaystreamPrincipled)

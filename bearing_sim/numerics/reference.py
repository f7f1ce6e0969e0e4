# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Parameters by reference: a pointer to a named tuple, whose fields compiled code reads where it uses them.

Numba passes a tuple by value, field by field: the parameters of a bearing and the memory of a level are 500 numbers and arrays in every call.  That
took a third of the time of a step, and most of the time of compiling went into the types and the copies.  A reference is one number, and reads the
same: ``model.params.rollers.radius``.  What it refers to does not change while compiled code runs, which the compiler is told, so that it reads a
field once.  (The elements of an array do change; the array's address and shape do not.)
"""

import hashlib

from llvmlite import ir
from numba.core import cgutils, types
from numba.core.datamodel import models, register_default
from numba.core.typing.templates import AttributeTemplate
from numba.extending import infer_getattr, intrinsic, lower_getattr_generic


class Reference(types.Type):
    """Type of a pointer to a named tuple.

    Attributes
    ----------
    whole : type of the tuple.
    """

    def __init__(self, whole):
        self.whole = whole
        digest = hashlib.sha256(str(whole).encode()).hexdigest()[:12]
        super().__init__(f"Reference({whole.instance_class.__name__}, {digest})")  # short: names of compiled functions contain it

    def field(self, name):
        """Return the type of a field as it is read: of a named tuple a reference."""
        found = self.whole.types[self.whole.fields.index(name)]
        return Reference(found) if isinstance(found, types.BaseNamedTuple) else found


@register_default(Reference)
class _ReferenceModel(models.OpaqueModel):
    pass


@infer_getattr
class _ReferenceFields(AttributeTemplate):
    key = Reference

    def generic_resolve(self, reference, name):
        if name in reference.whole.fields:
            return reference.field(name)


@lower_getattr_generic(Reference)
def _read_field(context, builder, reference, pointer, name):
    whole = context.get_value_type(reference.whole)
    place = cgutils.gep_inbounds(builder, builder.bitcast(pointer, whole.as_pointer()), 0, reference.whole.fields.index(name))
    if isinstance(reference.field(name), Reference):
        return builder.bitcast(place, cgutils.voidptr_t)
    return _load(builder, place)


def _load(builder, place):
    """Load a constant number by number: the compiler sees through these, and not through arrays and tuples that are loaded whole."""
    kind = place.type.pointee
    if not isinstance(kind, (ir.LiteralStructType, ir.ArrayType)):
        found = builder.load(place)
        found.set_metadata("invariant.load", builder.module.add_metadata([]))
        return found
    whole = ir.Constant(kind, ir.Undefined)
    for k in range(len(kind.elements) if isinstance(kind, ir.LiteralStructType) else kind.count):
        whole = builder.insert_value(whole, _load(builder, cgutils.gep_inbounds(builder, place, 0, k)), k)
    return whole


@intrinsic
def refer(context, value):
    """Return a reference to a named tuple; anything else as it is."""
    if not isinstance(value, types.BaseNamedTuple):
        return value(value), lambda context, builder, signature, arguments: arguments[0]

    def code(context, builder, signature, arguments):
        return builder.bitcast(cgutils.alloca_once_value(builder, arguments[0]), cgutils.voidptr_t)

    return Reference(value)(value), code

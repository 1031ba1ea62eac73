/* Forced into each C file that rosidl_generator_py writes, so that it needs nothing but Python's stable ABI.
   With these four redefined, what is left of Python.h is the same from 3.11 on. */
#define Py_LIMITED_API 0x030B0000
#include <Python.h>
#include <stdio.h>
#include <string.h>

static inline PyObject * borrowed_item(PyObject * sequence, Py_ssize_t index)
{
  return PyList_Check(sequence) ? PyList_GetItem(sequence, index) : PyTuple_GetItem(sequence, index);
}

#undef PySequence_Fast_GET_ITEM
#define PySequence_Fast_GET_ITEM(sequence, index) borrowed_item(sequence, index)
#define PyFloat_AS_DOUBLE(number) PyFloat_AsDouble(number)
#define PyBytes_AS_STRING(bytes) PyBytes_AsString(bytes)
#define PyUnicode_1BYTE_DATA(text) PyUnicode_AsUTF8AndSize(text, NULL)

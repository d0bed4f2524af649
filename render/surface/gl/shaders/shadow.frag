// A shadow map has depths alone.
void main()
{
}
